//! A plan over flat ground, around a field with a runway.

/// From A to B at 500 m, then these legs, and a landing. There are more fixes, and other parts before the main plan, if they are given.
pub fn document(fixes: &str, parts: &str, legs: &str) -> String {
    format!(
        r#"<flightPlan xmlns="urn:legwork:flight-plan:1" name="Test" aircraft="trainer">
             <fixes>
               <fix id="A" lat="36.30" lon="-84.20"/> <fix id="B" lat="36.30" lon="-84.16"/>
               <fix id="C" lat="36.33" lon="-84.16"/> {fixes}
             </fixes>
             <runways><runway id="R" lat="36.31" lon="-84.19" elevation="300" heading="90" length="500"/></runways>
             {parts}
             <mainPlan emergency="home">
               <stage id="s" type="en-route" altitude="500" altitudeReference="amsl">
                 <IF id="a" fix="A"/><TF id="b" fix="B"/>{legs}
               </stage>
               <stage id="l" type="land" runway="R"/>
             </mainPlan>
             <emergencyPlans><emergencyPlan id="home" runway="R">
               <stage id="e" type="arrival"><DF id="ed" fix="A" altitude="450" altitudeReference="amsl"/></stage>
               <stage id="el" type="land" runway="R"/></emergencyPlan></emergencyPlans>
           </flightPlan>"#
    )
}
